#!/bin/bash
# visibility  over-estimation and missed objects against milliseconds a view cell, where visibility fails, the octree; Chhugani et al. 2005, section 8
. "$(dirname "$0")/shared.sh"

# The verbs of the first two end with an error if a ray reaches an object that is reported hidden.
failures() { "$bench" visibility-failures --out "$part" --places "$1" >/dev/null; }
# producers SCENE OPTION...
producers() { "$bench" visibility-tables --csv "$part/tables.csv" "${@:2}" "$1" >/dev/null; }

# never_hidden RAYS [LEVEL]
never_hidden() { "$bench" never-hidden --rays "$@" | tee "$part/never_hidden.txt"; }
peer_pvs() { "$bench" peer-pvs "$levels" --csv "$part/peer_pvs.csv"; }

pictures() {
  local effort name=$part/pictures/dense-city
  mkdir "$part/pictures"
  "$vismat" dense-city --size 10 -o "$name.scene.h5"
  for effort in 0 1 2; do
    "$vismat" see "$name.scene.h5" --cells grid:4,4,1.5 --region 76,96,1,88,104,2.5 --producer sandwich --effort $effort \
      -o "$name.effort$effort.bsp.h5" --seen "$name.effort$effort.seen.bsp.h5"
  done
}

# octree LEVELS SCENE
octree() { "$bench" octree-tables --csv "$part/octree.csv" --levels "$@"; }

steps() {
  local scene places=3 cells=2 rays=1e7 octree_levels=4 level=()
  if [ -n "$full" ]; then places=8 cells=4 rays=1e9 octree_levels=6; fi
  if [ -n "$(present oa_koth1)" ]; then level=("$(level oa_koth1)"); fi
  step --beside 'what accuracy depends on and where producers fail' failures $places
  for scene in dense-city box-city tilted-boxes soup plant "${level[@]}"; do
    step "every producer compared with rays: $(basename "$scene" .bsp)" producers "$scene" --places $places --cells $cells ${full:+--long}
  done
  step 'rays against what is reported hidden' never_hidden $rays "${level[@]}"
  if [ -n "$full" ]; then step 'rays against the tables of the levels themselves' peer_pvs; fi
  step 'pictures of a cell' pictures
  for scene in dense-city plant; do step "octree: $scene" octree $octree_levels "$scene"; done
}

run_steps openarena-081-maps
