// vismat: one program, a file per verb. A verb parses, calls one library, prints.
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "cli/verbs.h"
#include "matrix/base/atomic_file.h"

namespace {

void interrupted(int signal) {
  vismat::remove_partial_files();
  ::_exit(128 + signal);
}

}  // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, interrupted);
  std::signal(SIGXFSZ, SIG_IGN);  // a file over its limit is an error to tell, as a full disk is
  CLI::App app(
      "vismat makes, reorders and compresses visibility matrices: which objects may be seen from which view "
      "cell.");
  app.name("vismat");
  app.set_version_flag("--version", VISMAT_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer(
      "Example: vismat import oa_koth1.bsp -o koth1.bsp.h5 && vismat info koth1.bsp.h5\n"
      "'vismat VERB --help' tells each verb's options, with an example.");
  using namespace vismat::cli;
  add_import(app);
  add_city(app);
  add_dense_city(app);
  add_plant(app);
  add_cells(app);
  add_generate(app);
  add_scene(app);
  add_see(app);
  add_triangles(app);
  add_tree(app);
  add_order(app);
  add_deltas(app);
  add_merge(app);
  add_verify(app);
  add_encode(app);
  add_decode(app);
  add_row(app);
  add_compare(app);
  add_node(app);
  add_convert(app);
  add_info(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "vismat: %s\n", error.what());
    return 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "vismat: not enough memory\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "vismat: %s\n", error.what());
    return 1;
  }
  return 0;
}
