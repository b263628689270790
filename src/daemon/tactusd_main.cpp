#include "tactus/daemon/daemon_program.h"

int main(int argc, char** argv) { return tactus::tactusdProgram(argc, argv); }
