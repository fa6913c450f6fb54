/* welkin_c_program PART: runs that part; without one, all. */
#include <stdio.h>
#include <string.h>

#include "support.h"

static const struct {
  const char* name;
  void (*run)(void);
} parts[] = {{"posting", posting},   {"releasing", releasing}, {"refusing", refusing},
             {"versions", versions}, {"exiting", exiting},     {"memory", memory}};

int main(int count, char** arguments) {
  size_t runs = 0;
  for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
    if (count > 1 && strcmp(arguments[1], parts[i].name) != 0) continue;
    printf("%s\n", parts[i].name);
    parts[i].run();
    ++runs;
  }
  if (runs == 0) fprintf(stderr, "there is no part of that name\n");
  return runs > 0 && failures() == 0 ? 0 : 1;
}
