#!/usr/bin/env bash
# Umbrage's rays per second beside those of Intel's Embree: the same triangles, rays and cores, in turns. Prints, for each
# scene, the medians of ROUNDS rounds and their ratio. Debian: apt-get install libembree-dev g++. Quiet machines only: a
# compiler that runs beside it halves either side.
#
#   bench/embree/run.sh [SCENE]...      ROUNDS=5 THREADS=2
set -euo pipefail
cd "$(dirname "$0")/../.."
rounds=${ROUNDS:-5}
threads=${THREADS:-$(nproc)}
scenes=("$@")
if [ ${#scenes[@]} = 0 ]; then
    scenes=(builtin:torus builtin:columns builtin:knots)
    for scene in kaykit-medieval-hexagon/village.gltf metal-rough-spheres-no-textures/MetalRoughSpheresNoTextures.glb \
        zdm2/zdm2.glb; do
        if [ -f "../shared/scenes/$scene" ]; then
            scenes+=("../shared/scenes/$scene")
        else
            echo "SKIPPED: ../shared/scenes/$scene is not there" >&2
        fi
    done
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cargo build --quiet --release -p umbrage-truth --example rays
g++ -O3 -march=native -std=c++17 bench/embree/occluded.cpp -o "$work/occluded" -lembree3 -pthread

median() { sort -g | awk '{ a[NR] = $1 } END { print (NR % 2) ? a[(NR + 1) / 2] : (a[NR / 2] + a[NR / 2 + 1]) / 2 }'; }
# The speed that Embree reaches in a mode (default build of its scene, not the robust one).
speed() { grep -o "\"mode\":\"$1\",\"robust\":false,\"mrays_per_s\":[0-9.]*" | grep -o '[0-9.]*$'; }

printf '%-34s %10s %9s %9s %9s %7s %7s %7s\n' 'scene (Mrays/s)' triangles umbrage occluded1 best-mode ratio1 ratio differ
for scene in "${scenes[@]}"; do
    : >"$work/ours" >"$work/one" >"$work/best" >"$work/ratio1" >"$work/ratio"
    for _ in $(seq "$rounds"); do
        ours=$(RAYON_NUM_THREADS=$threads target/release/examples/rays "$scene" "$work/dump")
        theirs=$("$work/occluded" "$work/dump" "$threads" 2)
        a=$(grep -o '"mrays_per_s":[0-9.]*' <<<"$ours" | grep -o '[0-9.]*$')
        one=$(speed occluded1 <<<"$theirs")
        best=$(for mode in occluded1 occluded8 occluded16 occluded1M; do speed $mode <<<"$theirs" || true; done | sort -g | tail -n 1)
        echo "$a" >>"$work/ours"
        echo "$one" >>"$work/one"
        echo "$best" >>"$work/best"
        awk "BEGIN { print $a / $one }" >>"$work/ratio1"
        awk "BEGIN { print $a / $best }" >>"$work/ratio"
    done
    triangles=$(grep -o '"triangles":[0-9]*' <<<"$ours" | grep -o '[0-9]*$')
    differ=$(grep -o '"differ":[0-9]*}$' <<<"$theirs" | grep -o '[0-9]*')
    printf '%-34s %10s %9.1f %9.1f %9.1f %7.2f %7.2f %7s\n' "$(basename "$scene")" "$triangles" "$(median <"$work/ours")" \
        "$(median <"$work/one")" "$(median <"$work/best")" "$(median <"$work/ratio1")" "$(median <"$work/ratio")" "$differ"
done
