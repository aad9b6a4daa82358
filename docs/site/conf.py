"""Configuration of Sphinx for the site; scripts/docs runs it on the pages that stage.py has put together."""

import pathlib
import re
import sys

here = pathlib.Path(__file__).resolve().parent
root = here.parent.parent
sys.path.insert(0, str(here))

project = "libmps"
author = copyright = "the libmps authors"
release = "{}.{}.{}{}".format(*re.findall(r'#define MPS_VERSION_(?:MAJOR|MINOR|PATCH|SUFFIX) "?([^"\s]*)', (root / "include/mps/base.h").read_text()))
version = release

extensions = ["myst_parser", "sphinx_design", "sphinx_copybutton", "sphinx.ext.mathjax", "links"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
# A local copy: equations are rendered without a network. tex-svg.js carries its fonts.
mathjax_path = "mathjax/tex-svg.js"
mathjax3_config = {"options": {"enableMenu": False}}  # the menu would fetch parts from the network
highlight_language = "none"
c_maximum_signature_line_length = 80
nitpicky = False
suppress_warnings = []

html_theme = "furo"
html_title = f"libmps {release}"
html_static_path = [str(here / "_static")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
html_search_scorer = str(here / "scorer.js")
copybutton_prompt_text = "$ "
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f4e79", "color-brand-content": "#1f5f99"},
    "dark_css_variables": {"color-brand-primary": "#8fc1ef", "color-brand-content": "#8fc1ef"},
}
