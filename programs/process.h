// What every program does at its start and its end, so that nothing that it writes is lost without a word.
#pragma once
#include <string>

namespace vismat {

/// Opens /dev/null in place of standard input, output and error where they are closed, or the next file to be opened
/// would take their numbers. From then on signals that end the program (Ctrl-C, those of batch systems) remove its
/// partial files first. A reader of standard output that went away does not end it: other results are still written.
void begin_process();

/// The exit code: `code`, unless standard output could not be written. Then it is 1, after one line on stderr; or 141,
/// as a shell tells of SIGPIPE, if nobody read it to its end.
int end_process(const std::string& program, int code);

}  // namespace vismat
