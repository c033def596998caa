"""Commands: what ``primkit`` does on the command line; ``__main__`` chooses one.

Beside the story: a command reads its options, calls the library, and says in plain words what came out.

In:  the words after ``primkit``.
Out: text on the screen, files in a folder; a wrong word is refused in one sentence.

>>> from primkit.commands.words import nearest
>>> nearest("stduy", ["map", "study"])
"; did you mean 'study'?"

Each command has its TEXT, its EXAMPLES, a function that adds its options to a parser and one that runs it. Nothing
heavy is loaded before a command runs: ``--help`` must answer at once.
"""
