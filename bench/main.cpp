// bench: one program with a source file for each verb. It reproduces the papers' tables and measures what they do not tell.
#include "bench/verbs.h"

namespace {

using namespace vismat::bench;

struct Entry {
  const char *group, *name, *what;
  void (*add)(const vismat::Verb&);
};

constexpr Entry entries[] = {
    {"Orders", "orders", "Every method of 'vismat order' on given matrices: runs, bound, seconds, memory",
     add_orders},
    {"Orders", "order-scale", "Orders at the papers' scale: runs, seconds and memory against size",
     add_order_scale},
    {"Orders", "order-failures", "Where orders fail: on adversarial matrices and on given ones",
     add_order_failures},
    {"Orders", "distance-statistics",
     "Chhugani et al. 2005, Fig. 6: the share of columns near a random column", add_distance_statistics},
    {"Orders", "flann-recall", "Recall and time of FLANN's indexes on columns in planted groups",
     add_flann_recall},
    {"Codecs", "zach-tables", "Zach & Karner 2003, Tables 1 and 2, for any matrices over a tree",
     add_zach_tables},
    {"Codecs", "gotsman-tables", "Gotsman's subset coding over trees of view cells", add_gotsman_tables},
    {"Codecs", "vlod-tables", "Chhugani et al. 2005, Table 2: differences between view cells, compressed",
     add_vlod_tables},
    {"Codecs", "panne-search", "Van de Panne and Stewart's search for clusters: bytes against seconds",
     add_panne_search},
    {"Codecs", "lossy-tables", "Bytes against added entries: merged view cells and objects, coded",
     add_lossy_tables},
    {"Codecs", "lossy-failures", "Where merging fails: on adversarial matrices and on given ones",
     add_lossy_failures},
    {"Codecs", "row-failures", "Worst-case rows: bytes and decoding time by each codec", add_row_failures},
    {"Codecs", "row-speed", "Speed of reading single rows from a .vmat file", add_row_speed},
    {"Codecs", "row-study",
     "What each part of rows-small buys, where its bits are, and what wrong orders and wrong entries cost",
     add_row_study},
    {"Codecs", "delimiter-speed", "Speed of the delimiter code's decoder and encoder", add_delimiter_speed},
    {"Codecs", "speed", "Speed of every codec and order on one matrix", add_speed},
    {"Codecs", "train-rows", "Trains the probabilities of rows-small and rows-quick on many matrices",
     add_train_rows},
    {"Walks", "cache-speed", "Speed of the cache of chunks: frames of a walk a second", add_cache_speed},
    {"Walks", "disk-walk", "Disk reads on a walk through levels, by the order of the faces on the disk",
     add_disk_walk},
    {"Walks", "walk-deltas",
     "Bytes of the differences that a walk crosses, by each codec that reads single rows", add_walk_deltas},
    {"Visibility", "visibility-tables", "Over-estimation and missed objects against time, for every producer",
     add_visibility_tables},
    {"Visibility", "visibility-failures", "Where and why producers of visibility fail",
     add_visibility_failures},
    {"Visibility", "octree-tables", "The adaptive octree of view cells, level by level", add_octree_tables},
    {"Visibility", "octants", "Makes a matrix of view cells x octants: what is seen of a level in an octree",
     add_octants},
    {"Visibility", "never-hidden", "Casts rays at objects reported hidden; fails if one arrives",
     add_never_hidden},
    {"Visibility", "peer-pvs",
     "Compares rays with a level's own visibility table, of the map compiler q3map2", add_peer_pvs},
    {"Visibility", "import-levels", "Speed of importing every level", add_import_levels},
    {"Growth", "growth", "Time and memory of the verbs of vismat on plants of growing size, with exponents",
     add_growth},
};

}  // namespace

int main(int argc, char** argv) {
  vismat::Program program(
      "bench", "bench reproduces the papers' tables and measures orders, codecs, walks and visibility.");
  program.example("bench zach-tables --out out koth1.bsp.h5");
  for (const Entry& entry : entries) entry.add(program.verb(entry.name, entry.what, entry.group));
  return program.run(argc, argv);
}
