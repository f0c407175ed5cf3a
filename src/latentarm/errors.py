"""The one error that is the user's to mend."""


class UserError(Exception):
    """Bad input, said in one clear sentence.

    The sentence names the file, the episode or the field, and what to do about it.
    The command line prints it without a traceback and exits with code 2.
    """
