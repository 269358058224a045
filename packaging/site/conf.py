"""Settings of the documentation site. `make docs` builds it; a broken link or any other warning fails the build.

The source is the whole project, so that links between pages, README.md and CHANGELOG.md are the same here and in the repository.
"""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

project = html_title = "safeloc"
extensions = ["myst_parser", "sphinx.ext.autodoc", "reference"]
root_doc = "packaging/site/index"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**.md", "packaging/site/*.md"]
html_extra_path = [str(HERE / "first")]
html_theme = "furo"
html_copy_source = html_show_sourcelink = False
nitpicky = True
myst_heading_anchors = 4
autodoc_typehints = "none"
autodoc_member_order = "bysource"
