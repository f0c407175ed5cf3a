"""Pictures are sent from the address of this computer that the page is served on, and from no other."""

import aioice.ice


def listen_only_on(host: str) -> None:
    """Make aioice listen on this numeric address alone, in this process.

    Otherwise it listens on every address but the loopback, where most pages are served.
    """

    def own_address(use_ipv4: bool, use_ipv6: bool) -> list[str]:
        return [host]

    aioice.ice.get_host_addresses = own_address
