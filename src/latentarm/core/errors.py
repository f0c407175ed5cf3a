"""The error for problems that the user can fix."""


class UserError(Exception):
    """Raised for problems the user can fix.

    The message is one sentence that names the file, the episode or the field, and says what to do.
    The command line prints it without a traceback and exits with code 2.
    """
