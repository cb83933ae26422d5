"""Saved states with a right checksum that were never saved: anybody can write one."""


def signed(state: bytearray, checksum: int) -> bytes:
    """The state with its checksum at a place: FNV-1a over all bytes but its own."""
    state[checksum : checksum + 8] = bytes(8)
    value = 14695981039346656037
    for byte in state:
        value = ((value ^ byte) * 1099511628211) % 2**64
    state[checksum : checksum + 8] = value.to_bytes(8, "little")
    return bytes(state)
