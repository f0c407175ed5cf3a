"""The driver of UFACTORY's arms: xArm 5, 6 and 7, 850, Lite 6.

It uses the layers of `xarm-python-sdk` that make and read frames, over sockets of its own. The SDK's
`XArmAPI` blocks for seconds, clears warnings when it connects, reconnects by itself, replaces NaN by the
figure before, and changes the time-out of every new socket of the process.
"""
