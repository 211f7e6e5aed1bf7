// The program vismat, with a file for each verb. A verb parses, calls one library and prints.
#include "cli/verbs.h"
#include "programs/options.h"

int main(int argc, char** argv) {
  vismat::Program program("vismat",
                          "vismat makes, reorders and compresses visibility matrices: which objects may be "
                          "seen from which view cell.",
                          VISMAT_VERSION);
  program.note("'vismat VERB --help' explains the options of each verb and gives an example.");
  program.example("vismat import oa_koth1.bsp -o koth1.bsp.h5 && vismat info koth1.bsp.h5");
  using namespace vismat::cli;
  add_import(program);
  add_city(program);
  add_dense_city(program);
  add_plant(program);
  add_cells(program);
  add_generate(program);
  add_scene(program);
  add_see(program);
  add_triangles(program);
  add_tree(program);
  add_order(program);
  add_deltas(program);
  add_bake(program);
  add_path(program);
  add_walk(program);
  add_merge(program);
  add_verify(program);
  add_encode(program);
  add_decode(program);
  add_row(program);
  add_compare(program);
  add_node(program);
  add_convert(program);
  add_info(program);
  return program.run(argc, argv);
}
