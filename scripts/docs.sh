#!/bin/sh
# Writes the pages of docs/ that the declarations give anew; a page whose command fails stays as it is.
set -eu
cd "$(dirname "$0")/.."
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT

say() {
    .venv/bin/mfr-bench "$@" >"$new/said"
}

page() {  # NAME ARGUMENTS...: the whole page
    name=$1
    shift
    say "$@"
    cat "$new/said" >"docs/$name.md"
}

page methods methods --markdown
page fairness methods --fairness
page results table --columns
page experiments configs --markdown
page fidelity configs --fidelity
say configs --kinds
sed -e '/^<!-- kinds/,/^<!-- end of kinds/d' -e '/^## Kinds and layouts/{n;r '"$new/said"'
}' docs/scenes.md >"$new/page"
cat "$new/page" >docs/scenes.md
