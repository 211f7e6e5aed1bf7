#!/bin/bash
# row-tables  trains the probabilities of rows-small and rows-quick, out/row-tables/row_tables.cpp, and says whether the codecs have the same
. "$(dirname "$0")/shared.sh"

# Other levels, and other octants of these, are for checking.
names=(
  {aggressor,am_underworks2,oa_koth1,oa_spirit3,oacmpdm4,oacmpdm9,wrackdm17}.{cells,faces}
  aggressor.faces.differences oa_spirit3.cells.differences
  {E1M1,E2M3,MAP10,MAP20}.cells
  {oa_thor,ctf_compromise,dense-city,plant}.octants
)

train() {
  local name files=() verdict=differ
  for name in "$@"; do files+=("$(matrix "$name")"); done
  "$bench" train-rows "${files[@]}" --out "$part/row_tables.cpp" | tee "$part/training.txt"
  if cmp -s "$part/row_tables.cpp" codecs/modelled/row_tables.cpp; then verdict='are equal'; fi
  say "row_tables.cpp in $out and in codecs/modelled $verdict"
}

steps() {
  local name trained=()
  for name in $(present "${names[@]}"); do
    trained+=("$name")
    step "matrix $name" make_matrix "$name"
  done
  step training train "${trained[@]}"
}

run_steps openarena-081-maps openarena-085-data openarena-088-data openarena-oacmp1 freedoom
