#!/usr/bin/env bash
# tools/docs as a user runs it: the whole site, then faults that must end it. Root, or the packages of tools/docs_packages.txt.
set -euo pipefail
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)
fail() {
  echo "docs: FAILED: $*" >&2
  exit 1
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$project/tools/docs" --out "$folder/site" | tee "$folder/log"
[ "$(tail -n 1 "$folder/log")" = "$folder/site/index.html" ] || fail "the last line is not the path of the first page"
# shows PAGE TEXT: what came from a document, an idl file, a header's head and a member's comment.
shows() { grep -q -e "$2" "$folder/site/$1" || fail "$1 does not show '$2'"; }
shows index.html '<h1 id="sinew">Sinew'
shows docs/tutorial.html 'href="glossary.html"'
shows ARCHITECTURE.html 'src="ARCHITECTURE_1.svg"'
shows idl/joint.html 'struct JointState'
shows api.html 'href="api/rls_8h.html"'
shows api/rls_8h.html 'Recursive least squares with forgetting'
shows api/structsinew_1_1rls_1_1Config.html 'lambda in (0, 1\]; 1: nothing is forgotten'
python3 - "$folder/site/search/index.js" << 'END' || fail "the index of the search"
import json, sys
places = json.loads(open(sys.argv[1], encoding="utf-8").read().removeprefix("const places = ").rstrip(";\n"))
found = [place["location"] for place in places if "pneumatic element" in place["text"]]
assert len(places) > 500 and "index.html#sinew" in found, found
END

# Again in the same place; nothing but a site is replaced.
"$project/tools/docs" --out "$folder/site" > "$folder/log" || fail "a site is not replaced: $(cat "$folder/log")"
mkdir "$folder/mine" && touch "$folder/mine/file"
! "$project/tools/docs" --out "$folder/mine" > "$folder/log" 2>&1 || fail "a folder of somebody else is replaced"
[ -e "$folder/mine/file" ] || fail "a folder of somebody else is deleted"

# refused WHAT DOCUMENT LINE: the line at the end of the document ends the command, whose last line has WHAT, and leaves no site.
mkdir "$folder/copy"
tar -C "$project" --exclude=./build --exclude=./.git --exclude=CMakeLists.txt -c . | tar -C "$folder/copy" -x
cp {"$project","$folder/copy"}/components/learn/rls/CMakeLists.txt  # headers of one module alone
refused() {
  cp "$folder/copy/$2" "$folder/kept"
  printf '\n%s\n' "$3" >> "$folder/copy/$2"
  ! "$folder/copy/tools/docs" --out "$folder/faulty" > "$folder/log" 2>&1 || fail "'$3' is accepted"
  tail -n 1 "$folder/log" | grep -q -e "^tools/docs: .*$1" || fail "'$3': expected '$1' in the last line of: $(cat "$folder/log")"
  [ ! -e "$folder/faulty" ] || fail "'$3' leaves a site"
  cp "$folder/kept" "$folder/copy/$2"
}
refused "MkDocs: .*docs/model.md.*nowhere.md" docs/model.md '[a dead link](nowhere.md)'
refused "docs/model.html -> .*nowhere: no such place" docs/model.md '[a dead place](data-gate.md#nowhere)'
refused "docs/model.html loads https://example.org" docs/model.md '<img src="https://example.org/x.png">'
"$folder/copy/tools/docs" --out "$folder/faulty" > "$folder/log" 2>&1 || fail "the copy without faults: $(cat "$folder/log")"
echo "docs: all checks passed"
