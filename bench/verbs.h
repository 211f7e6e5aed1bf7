// The functions that add each verb to bench: its options, help and what it runs. Each is in the source file of that name.
#pragma once
#include "programs/options.h"

namespace vismat::bench {

void add_cache_speed(const Verb& verb);
void add_delimiter_speed(const Verb& verb);
void add_disk_walk(const Verb& verb);
void add_distance_statistics(const Verb& verb);
void add_flann_recall(const Verb& verb);
void add_gotsman_tables(const Verb& verb);
void add_growth(const Verb& verb);
void add_import_levels(const Verb& verb);
void add_lossy_failures(const Verb& verb);
void add_lossy_tables(const Verb& verb);
void add_never_hidden(const Verb& verb);
void add_octants(const Verb& verb);
void add_octree_tables(const Verb& verb);
void add_order_failures(const Verb& verb);
void add_order_scale(const Verb& verb);
void add_orders(const Verb& verb);
void add_panne_search(const Verb& verb);
void add_peer_pvs(const Verb& verb);
void add_row_failures(const Verb& verb);
void add_row_speed(const Verb& verb);
void add_row_study(const Verb& verb);
void add_speed(const Verb& verb);
void add_train_rows(const Verb& verb);
void add_visibility_failures(const Verb& verb);
void add_visibility_tables(const Verb& verb);
void add_vlod_tables(const Verb& verb);
void add_walk_deltas(const Verb& verb);
void add_zach_tables(const Verb& verb);

}  // namespace vismat::bench
