#pragma once

#include "tests/app/command.h"

namespace osteon::app {

/// The result of a demo of 1.5 s in virtual time. Its files are in a/b, its motion in motion.csv.
struct ShortRun {
  TemporaryFolder folder;
  CommandResult run = RunCommand(folder.path(), {"demo", "--virtual-time", "--seconds", "1.5", "--out", "a/b",
                                                 "--json", "copy.json", "--save-motion", "motion.csv"});
};
/// The short run that all tests of the suite VirtualDemo share. ctest runs the suite in one process.
inline const ShortRun& SharedShortRun() {
  static const ShortRun made;
  return made;
}

}  // namespace osteon::app
