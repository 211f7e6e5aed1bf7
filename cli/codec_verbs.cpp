#include "cli/verbs.h"
namespace vismat::cli { void add_encode(CLI::App&) {} void add_decode(CLI::App&) {} void add_node(CLI::App&) {} }
