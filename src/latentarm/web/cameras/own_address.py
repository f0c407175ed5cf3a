"""Pictures are sent from the address of this computer that the page is served on, and from no other."""

import aioice.ice


def listen_only_on(host: str) -> None:
    """From now on in this process.

    Otherwise aioice listens on every address but the loopback, which is where most pages are served.

    Args:
        host: an address of this computer, as a number.
    """

    def own_address(use_ipv4: bool, use_ipv6: bool) -> list[str]:
        return [host]

    aioice.ice.get_host_addresses = own_address
