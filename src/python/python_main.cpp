#include "tactus/python/bindings.h"

PYBIND11_MODULE(_core, module) {
  module.doc() = "What the package tactus is made of; import that.";
  module.attr("VERSION") = TACTUS_VERSION;
  tactus::bindErrors();
  tactus::bindColumns(module);
  tactus::bindScene(module);
  tactus::bindRuns(module);
  tactus::bindController(module);
}
