#include <cstdio>
#include <iostream>
#include <map>
#include <string>

#include "model/mode_model.h"

/// Writes on standard output what is made from the tables of modes, faults and brakes; `agree`
/// reads the model's steps from standard input and fails where the code takes others.
int main(int argc, char** argv) {
  using namespace tactus::model;
  const std::string what = argc == 2 ? argv[1] : "";
  const std::map<std::string, std::string (*)()> texts = {
      {"promela", promelaModel}, {"modes", modeTable},    {"hazards", hazardTable},
      {"remedies", remedyTable}, {"modes.8", modeManual}, {"faults.8", faultManual}};
  std::ios::sync_with_stdio(false);
  if (what == "agree") return agrees(std::cin, std::cout) ? 0 : 1;
  const auto text = texts.find(what);
  if (text == texts.end()) {
    std::cerr
        << "usage: mode_model promela | modes | hazards | remedies | modes.8 | faults.8 | agree\n";
    return 2;
  }
  std::cout << text->second();
  return 0;
}
