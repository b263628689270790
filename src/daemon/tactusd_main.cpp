#include "tactus/daemon/programs.h"

int main(int argc, char** argv) { return tactus::tactusdProgram(argc, argv); }
