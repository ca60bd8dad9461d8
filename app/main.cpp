#include "app/cli/osteon_program.h"

int main(int argc, char** argv) { return osteon::app::RunOsteon(argc, argv); }
