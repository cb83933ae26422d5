"""How a message quotes a value that it got, which may come from a stranger's file."""

_LONGEST = 80  # characters


def quoted(value: object) -> str:
    """Returns the value as Python writes it, in one line and cut after 80 characters."""
    if isinstance(value, (str, bytes)):
        value = value[: _LONGEST + 1]  # so that a long text is not copied
    try:
        return cut(repr(value))
    except ValueError:  # Python limits the number of digits of an integer as text
        return "a number with too many digits"
    except RecursionError:
        return "values in values"


def cut(text: str) -> str:
    """Cuts a text after 80 characters."""
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def cause(error: BaseException) -> str:
    """Returns what an error of a library says in one line, with little text of the file."""
    return cut(" ".join(str(error).split()) or type(error).__name__)
