"""The job of `sigmahat report`: finds out what a folder holds, and makes one HTML file of it."""

from __future__ import annotations

from pathlib import Path

from bokeh.embed import components
from bokeh.resources import Resources
from jinja2 import Environment, StrictUndefined

from sigmahat.report import series, sweep
from sigmahat.report.plots import Contents, plots

_TEMPLATE = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none';
 script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:">
<link rel="icon" href="data:,">
<title>{{ contents.title }}</title>
<style>
:root {
  color-scheme: light dark;
  --page: #ffffff; --ink: #1b1f24; --soft: #59636e; --line: #d8dde3; --box: #f5f7f9;
}
@media (prefers-color-scheme: dark) {
  :root { --page: #14171b; --ink: #e4e8ec; --soft: #9aa4af; --line: #343b43; --box: #1c2127; }
}
:root {
  --bk-background-fill-color: var(--page); --bk-border-fill-color: var(--page);
  --bk-outline-line-color: var(--line); --bk-grid-line-color: var(--line);
  --bk-axis-line-color: var(--soft); --bk-major-tick-line-color: var(--soft);
  --bk-minor-tick-line-color: var(--line); --bk-major-label-text-color: var(--soft);
  --bk-axis-label-text-color: var(--ink);
}
body { margin: 0 auto; padding: 1rem; max-width: 1500px; background: var(--page);
  color: var(--ink); font: 15px/1.45 system-ui, sans-serif; }
h1 { font-size: 1.4rem; margin: 0 0 .3rem; overflow-wrap: anywhere; }
h2 { font-size: 1.05rem; margin: 0 0 .3rem; overflow-wrap: anywhere; }
p { margin: .2rem 0; color: var(--soft); max-width: 75ch; overflow-wrap: anywhere; }
section { margin-top: 1.6rem; min-width: 0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .88rem; }
th, td { padding: .25rem .7rem; text-align: right; border-bottom: 1px solid var(--line);
  white-space: nowrap; }
th { background: var(--box); font-weight: 600; white-space: normal; vertical-align: bottom; }
th:first-child, td:first-child, .words { text-align: left; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 560px), 1fr));
  column-gap: 1.5rem; }
.switches { display: flex; flex-wrap: wrap; gap: .1rem .9rem; font-size: .88rem; }
.switches label { display: inline-flex; align-items: center; gap: .35rem; cursor: pointer; }
.switches i { width: 1.1rem; height: .25rem; border-radius: 2px; }
.switches input { margin: 0; }
</style>
</head>
<body>
<h1>{{ contents.title }}</h1>
{%- for line in contents.lines %}
<p>{{ line }}</p>
{%- endfor %}
{%- for table in contents.tables %}
<section>
<h2>{{ table.title }}</h2>
<div class="wide"><table>
<thead><tr>
{%- for cell in table.head %}
<th{% if table.words[loop.index0] %} class="words"{% endif %}>{{ cell }}</th>
{%- endfor %}
</tr></thead>
<tbody>
{%- for row in table.rows %}
<tr>
{%- for cell in row %}
<td{% if table.words[loop.index0] %} class="words"{% endif %}>{{ cell }}</td>
{%- endfor %}
</tr>
{%- endfor %}
</tbody>
</table></div>
{%- if "*" in table.head|join %}
<p>* in the second half</p>
{%- endif %}
</section>
{%- endfor %}
<div class="plots">
{%- for plot, div in plots %}
<section>
<h2>{{ plot.panel.title }}</h2>
<div class="switches">
{%- for trace, name in plot.switches %}
<label><input type="checkbox" checked data-trace="{{ name }}">
<i style="background:{{ trace.color }}"></i>{{ trace.label }}</label>
{%- endfor %}
</div>
{{ div|safe }}
</section>
{%- endfor %}
</div>
{{ library|safe }}
{{ script|safe }}
<script>
"use strict";
const models = () => Bokeh.documents.flatMap(d => [...d._all_models.values()]);
document.addEventListener("change", event => {
  const name = event.target.dataset.trace;
  for (const model of models())
    if (model.name === name) model.visible = event.target.checked;
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => location.reload());
</script>
</body>
</html>
"""


def report(folder: Path) -> str:
    """HTML with the tables and plots of a reproduction, a log or a sweep.

    folder  where `sigmahat reproduce`, `estimate` or `sweep` wrote its results

    Raises ValueError, which says what to do, if the folder holds nothing of that or damaged files.
    """
    if not folder.is_dir():
        raise ValueError(
            f"{folder}: expected a folder of `sigmahat reproduce`, `estimate` or `sweep`"
        )
    kinds = {
        "sweep.parquet": sweep.sweep,
        "table.csv": series.reproduction,
        "estimate.parquet": series.log,
        "estimate.csv": series.log,
    }
    for name, read in kinds.items():
        if (folder / name).is_file():
            return _page(read(folder))
    if (folder / "runs.jsonl").is_file():
        raise ValueError(f"{folder}: a sweep that is not complete; run its command again first")
    raise ValueError(
        f"{folder}: no result of `sigmahat reproduce`, `estimate` or `sweep` "
        f"(expected one of {', '.join(kinds)})"
    )


def _page(contents: Contents) -> str:
    """The report as HTML."""
    made = plots(contents.panels, contents.every)
    script, divs = components([plot.figure for plot in made]) if made else ("", [])
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    return environment.from_string(_TEMPLATE).render(
        contents=contents,
        plots=list(zip(made, divs, strict=True)),
        library=Resources(mode="inline", components=["bokeh"]).render(),
        script=script,
    )
