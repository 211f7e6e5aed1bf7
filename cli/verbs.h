// Each verb adds itself to the program: its options, its help with an example, and what it does.
#pragma once
#include <CLI/CLI.hpp>

namespace vismat::cli {

void add_import(CLI::App& app);
void add_city(CLI::App& app);
void add_dense_city(CLI::App& app);
void add_plant(CLI::App& app);
void add_cells(CLI::App& app);
void add_generate(CLI::App& app);
void add_scene(CLI::App& app);
void add_see(CLI::App& app);
void add_triangles(CLI::App& app);
void add_tree(CLI::App& app);
void add_order(CLI::App& app);
void add_deltas(CLI::App& app);
void add_merge(CLI::App& app);
void add_verify(CLI::App& app);
void add_encode(CLI::App& app);
void add_decode(CLI::App& app);
void add_compare(CLI::App& app);
void add_row(CLI::App& app);
void add_node(CLI::App& app);
void add_convert(CLI::App& app);
void add_info(CLI::App& app);

}  // namespace vismat::cli
