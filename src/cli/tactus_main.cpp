#include "tactus/cli/commands.h"

int main(int argc, char** argv) { return tactus::tactusProgram(argc, argv); }
