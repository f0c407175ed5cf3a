"""The driver of UFACTORY's arms: xArm 5, 6 and 7, 850, Lite 6.

It speaks the manufacturer's protocol through the layers of `xarm-python-sdk` that make and read its frames,
over sockets of its own. The SDK's `XArmAPI` is not used: it blocks for seconds, clears warnings when it
connects, reconnects by itself, replaces NaN by the figure before, and changes the time-out of every new
socket of the process.
"""
