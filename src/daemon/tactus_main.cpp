#include "tactus/daemon/programs.h"

int main(int argc, char** argv) { return tactus::tactusProgram(argc, argv); }
