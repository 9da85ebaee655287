// make_creature_tree NAME OUT.json: writes one of the benchmarks' creatures as a scene file.
#include <cstdio>
#include <fstream>

#include "bench/creature_tree.h"

int main(int argc, char** argv) {
  using kelpie::CreatureWarps;
  if (argc == 3)
    for (const CreatureWarps warps : {CreatureWarps::none, CreatureWarps::twist, CreatureWarps::bend}) {
      if (argv[1] != kelpie::creature_name(warps)) continue;
      std::ofstream out(argv[2]);
      out << kelpie::make_creature_scene(warps) << std::flush;
      if (!out) std::fprintf(stderr, "make_creature_tree: %s: could not be written\n", argv[2]);
      return out ? 0 : 74;
    }
  std::fprintf(stderr, "usage: make_creature_tree creature|creature_twisted|creature_bent OUT.json\n");
  return 2;
}
