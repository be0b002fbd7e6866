"""The text of a CODE V sequence to commands.

`;` parts commands, `&` at the end of a line goes on with the next one, `!` starts a comment, texts
stand in single or double quotes.
"""

import re
from dataclasses import dataclass

from ..draft.source_text import excerpt

# A quote that is not closed takes the rest of the line.
_TOKEN = re.compile(
    r"(?P<label>[Ll]'[^']*')|'(?P<single>[^']*)'|\"(?P<double>[^\"]*)\"|(?P<open>['\"].*)|(?P<comment>!.*)"
    r"|(?P<part>;)|(?P<word>[^\s;!]+)"
)


@dataclass(frozen=True)
class Command:
    """One command.

    Parameters
    ----------
    line : int
        Where it starts.
    words : tuple of str
        The first one, its keyword, in capitals; quotes are taken off.
    """

    line: int
    words: tuple[str, ...]

    @property
    def keyword(self):
        """The first word."""
        return self.words[0]

    @property
    def text(self):
        """The words as a message shows them."""
        return excerpt(" ".join(self.words[:12]))


def commands(lines, refusals):
    """Part a sequence into its commands.

    Parameters
    ----------
    lines : list of (int, str)
    refusals : Refusals
        Gets an I07 for each quote that is not closed.

    Returns
    -------
    list of Command
    """
    found, words, start = [], [], None
    for line, text in lines:
        goes_on = False
        for token in _TOKEN.finditer(text):
            kind = token.lastgroup
            if kind == "comment":
                break
            if kind == "open":
                refusals.add("I07", line, f"{excerpt(token.group())}: the quote is not closed")
                break
            goes_on = token.group() == "&"
            if kind == "part":
                _close(found, words, start)
                words = []
            elif not goes_on:
                start = start if words else line
                words.append(token.group(kind))
        if not goes_on:
            _close(found, words, start)
            words = []
    _close(found, words, start)
    return found


def _close(found, words, start):
    if words:
        found.append(Command(start, (words[0].upper(), *words[1:])))
