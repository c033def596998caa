"""The package's page: README.md with links that hold everywhere, and the addresses of whoever owns the project.

In:  README.md, and the one line ``owner`` in pyproject.toml.
Out: what hatch writes into the package: its page, its addresses, its maintainer.

README.md marks what is true in the project's folder alone, and holds what the package says instead as a comment:

    <!-- folder -->  ...  <!-- end of folder -->
    <!-- package  ...  -->
"""

import re
from pathlib import Path

from hatchling.metadata.plugin.interface import MetadataHookInterface

FOLDER = re.compile(r"<!-- folder -->.*?<!-- end of folder -->\n*", re.DOTALL)
PACKAGE = re.compile(r"<!-- package\n(.*?)-->", re.DOTALL)
LINK = re.compile(r"(\]\(|src=\")(?!https?:|#)([^)\"]+)")
PICTURE = (".png", ".svg", ".gif", ".webp")


class PackagePage(MetadataHookInterface):
    """Fills in what pyproject.toml calls dynamic."""

    def update(self, metadata: dict) -> None:
        """Fill it in."""
        owner, project = self.config["owner"], f"{self.config['owner']}/primkit"
        readme = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": page(readme, project, metadata["version"])}
        metadata["maintainers"] = [{"name": owner, "email": f"{owner}@users.noreply.github.com"}]
        metadata["urls"] = {
            "Source": f"https://github.com/{project}",
            "Site": f"https://{owner}.github.io/primkit/",
            "Issues": f"https://github.com/{project}/issues",
            "Changelog": f"https://github.com/{project}/blob/main/.github/CHANGELOG.md",
        }


def page(readme: str, project: str, version: str) -> str:
    r"""Return README.md as the package's page has it.

    >>> page("<!-- folder -->\nHere\n<!-- end of folder -->\n[a](LICENSE)", "me/kit", "1.0")
    '[a](https://github.com/me/kit/blob/v1.0/LICENSE)'
    """

    def absolute(match: re.Match[str]) -> str:
        raw = f"https://raw.githubusercontent.com/{project}/v{version}/"
        file = f"https://github.com/{project}/blob/v{version}/"
        return match[1] + (raw if match[2].endswith(PICTURE) else file) + match[2]

    return LINK.sub(absolute, PACKAGE.sub(r"\1", FOLDER.sub("", readme)))
