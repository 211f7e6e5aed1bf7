// Each verb adds itself to the program: its options, its help with an example, and what it runs.
#pragma once

namespace vismat {
class Program;
}

namespace vismat::cli {

void add_import(Program& program);
void add_city(Program& program);
void add_dense_city(Program& program);
void add_plant(Program& program);
void add_cells(Program& program);
void add_generate(Program& program);
void add_scene(Program& program);
void add_see(Program& program);
void add_triangles(Program& program);
void add_tree(Program& program);
void add_order(Program& program);
void add_deltas(Program& program);
void add_path(Program& program);
void add_merge(Program& program);
void add_verify(Program& program);
void add_encode(Program& program);
void add_decode(Program& program);
void add_compare(Program& program);
void add_row(Program& program);
void add_node(Program& program);
void add_convert(Program& program);
void add_bake(Program& program);
void add_walk(Program& program);
void add_info(Program& program);

}  // namespace vismat::cli
