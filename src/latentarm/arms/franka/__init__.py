"""Franka Research 3 and Panda over the Franka Control Interface, by franky-control.

`arm.py` is the driver; `worker.py` the thread that talks to the arm; `link.py` the connection, made and
checked; `hand.py` the Franka Hand in a thread of its own; `limits.py` what each arm can do; `options.py` what
an address sets; `words.py` the arm's errors in sentences.
"""
