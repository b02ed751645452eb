// A program outside the source tree: the installed headers and libraries are enough to build it.
#include <cstdio>

#include "host/version.h"
#if __has_include("host/world.h")
#include "host/world.h"
#endif

int main() {
  std::printf("scree %s\n", scree::version());
  return 0;
}
