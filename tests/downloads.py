"""Downloads, made as Moodle, Canvas, nbgrader's exchange and mail programs name and pack what was handed in."""

import io
import json
import re
import time
import zipfile
from email.message import EmailMessage
from email.utils import formatdate


def packed(files, *, when=(2026, 3, 1, 12, 0, 0)):
    """Return a zip: name -> content, or (content, when)."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            content, written = content if isinstance(content, tuple) else (content, when)
            archive.writestr(zipfile.ZipInfo(name, written), content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def moodle(name, number, file, *, flat=False, older=True):
    """The name of a file in Moodle's download; before version 4.1 with one more underscore."""
    folder = f"{name}_{number}_assignsubmission_file"
    return f"{folder}_{file}" if flat else f"{folder}{'_' if older else ''}/{file}"


def canvas(first, last, user, attachment, file, *, late=False):
    """The name of a file in Canvas's download."""
    called = re.sub(r"\W", "", f"{last}{first}").lower()
    return f"{called}_{'LATE_' if late else ''}{user}_{attachment}_{file}"


def exchange(student, name, when, code="x7Gq"):
    """The name of a folder in nbgrader's exchange."""
    return f"{student}+{name}+{when}+{code}"


def mail(sender, when, files):
    """An e-mail with attachments: when is in s since 1970."""
    message = EmailMessage()
    message["From"], message["Date"], message["Subject"] = f"Somebody <{sender}>", formatdate(when), "my homework"
    message.set_content("Here it is.")
    for name, content in files.items():
        message.add_attachment(content, maintype="application", subtype="octet-stream", filename=name)
    return message.as_bytes()


def clock(*when):
    """Return a time by this computer's clock, as archives hold it, in s since 1970."""
    return time.mktime((*when, *(0,) * (6 - len(when)), 0, 0, -1))


def edition_3(notebook):
    """Return a notebook as IPython 3 wrote it: cells in a worksheet, code as input."""
    cells = []
    for cell in notebook["cells"]:
        old = {key: value for key, value in cell.items() if key in ("cell_type", "metadata", "source")}
        if cell["cell_type"] == "code":
            old |= {"input": old.pop("source"), "language": "python", "outputs": [], "collapsed": False}
        cells.append(old)
    about = {"name": "", "signature": ""}
    return {"metadata": about, "nbformat": 3, "nbformat_minor": 0, "worksheets": [{"cells": cells, "metadata": {}}]}


def with_outputs(notebook, megabytes):
    """Return a notebook with pictures and text of so many megabytes."""
    copy = json.loads(json.dumps(notebook))
    code = next(cell for cell in copy["cells"] if cell["cell_type"] == "code")
    picture = {"image/png": "iVBORw0KGgo" * (megabytes * 2**20 // 22)}
    lines = ["again and again\n"] * (megabytes * 2**20 // 40)
    code["outputs"] = [
        {"output_type": "display_data", "metadata": {}, "data": picture},
        {"output_type": "stream", "name": "stdout", "text": lines},
    ]
    return copy
