#include "cli/verbs.h"
namespace vismat::cli { void add_convert(CLI::App&) {} }
