"""Tables as aligned columns of text."""


def text_table(rows, right=()):
    """Return rows of words as aligned columns.

    Parameters
    ----------
    rows : list of list of str
        Of equal length.
    right : collection of int
        Columns that end, rather than start, at one place.

    Returns
    -------
    str
    """
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = []
    for row in rows:
        words = [
            word.rjust(width) if column in right else word.ljust(width)
            for column, (word, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(words).rstrip())
    return "\n".join(lines)
