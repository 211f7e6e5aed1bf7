// bench: one program, a file a verb. It reproduces the papers' tables and measures what they do not tell.
#include "bench/verbs.h"

namespace {

using namespace vismat::bench;

struct Entry {
  const char *group, *name, *what;
  void (*add)(const vismat::Verb&);
};

constexpr Entry entries[] = {
    {"Orders", "orders", "Every order of the table on any matrices, each in a process of its own",
     add_orders},
    {"Orders", "order-scale", "Orders at the papers' scale: cost against size", add_order_scale},
    {"Orders", "order-failures", "Where orders fail: on matrices made to hurt, and on given ones",
     add_order_failures},
    {"Orders", "distance-statistics", "Chhugani et al. 2005, Fig. 6: the share of points near a random point",
     add_distance_statistics},
    {"Orders", "flann-recall", "Recall and time of FLANN's indices on columns of planted clusters",
     add_flann_recall},
    {"Codecs", "zach-tables", "Zach & Karner 2003, Tables 1 and 2, for any matrices over a tree",
     add_zach_tables},
    {"Codecs", "gotsman-tables", "Gotsman's subset coding over trees of view cells", add_gotsman_tables},
    {"Codecs", "vlod-tables", "Chhugani et al. 2005, Table 2: differences between view cells, compressed",
     add_vlod_tables},
    {"Codecs", "panne-search", "Van de Panne and Stewart's search for clusters: bytes against seconds",
     add_panne_search},
    {"Codecs", "lossy-tables", "Bytes against extra visible entries: merged cells and objects, coded",
     add_lossy_tables},
    {"Codecs", "lossy-failures", "Where merging fails: on matrices made to hurt, and on given ones",
     add_lossy_failures},
    {"Codecs", "row-failures", "Rows that are worst for a code", add_row_failures},
    {"Codecs", "row-speed", "Single rows out of a .vmat file", add_row_speed},
    {"Codecs", "delimiter-speed", "The delimiter code's decoder and encoder", add_delimiter_speed},
    {"Codecs", "speed", "Every codec and order on one matrix", add_speed},
    {"Walks", "disk-walk", "Disk reads on a walk through levels, by the order of their faces on the disk",
     add_disk_walk},
    {"Walks", "walk-deltas", "What changes at each boundary on a walk, and its bytes by each codec of rows",
     add_walk_deltas},
    {"Visibility", "visibility-tables", "Over-estimation and missed objects against time, for every producer",
     add_visibility_tables},
    {"Visibility", "visibility-failures", "Where and why visibility from cells fails",
     add_visibility_failures},
    {"Visibility", "octree-tables", "The adaptive octree of view cells, level by level", add_octree_tables},
    {"Visibility", "never-hidden", "Does any ray reach what is reported hidden?", add_never_hidden},
    {"Visibility", "peer-pvs", "Do rays reach only what a level's own visibility table lists?", add_peer_pvs},
    {"Visibility", "import-levels", "How long importing every level takes", add_import_levels},
};

}  // namespace

int main(int argc, char** argv) {
  vismat::Program program(
      "bench", "bench reproduces the papers' tables and measures orders, codecs, walks and visibility.");
  program.example("bench zach-tables --out out koth1.bsp.h5");
  for (const Entry& entry : entries) entry.add(program.verb(entry.name, entry.what, entry.group));
  return program.run(argc, argv);
}
