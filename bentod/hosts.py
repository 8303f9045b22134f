"""What an address tells: whether it is this machine, and whom attempts and connections are counted for."""

from ipaddress import IPv4Address, IPv6Address, ip_address, ip_network

LOOPBACK = "127.0.0.0/8"


def is_this_machine(host: str) -> bool:
    """Whether only programs on this machine reach `host`; of other names than localhost nobody can tell."""
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False


def network(host: str) -> str:
    """An IPv4 address, or an IPv6 network of 64 bits, which one machine may have; ours are all one."""
    address: IPv4Address | IPv6Address = ip_address(host.partition("%")[0])
    if isinstance(address, IPv6Address) and address.ipv4_mapped:
        address = address.ipv4_mapped
    if address.is_loopback:
        return LOOPBACK
    return str(address if address.version == 4 else ip_network((address, 64), strict=False))
