// The program scree. Exit codes: 0 done, 1 a run failed, 2 bad input.

#include <cstdio>
#include <exception>
#include <new>
#include <system_error>

#include "host/cli/command_line.h"
#include "host/error.h"
#include "host/io/streams.h"

int main(int argc, char** argv) {
  scree::prepare_streams();
  try {
    const int code = scree::run_command_line(argc, argv);
    scree::finish_output();
    return code;
  } catch (const scree::InputError& error) {
    return scree::fail(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return scree::fail("host memory exhausted", 1);
  } catch (const std::system_error& error) {
    // The formatting library reports only a reason when standard output cannot be written.
    if (std::ferror(stdout) == 0) return scree::fail(error.what(), 1);
    return scree::fail("cannot write standard output: " + error.code().message(), 1);
  } catch (const std::exception& error) {
    return scree::fail(error.what(), 1);
  }
}
