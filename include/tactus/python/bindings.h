#pragma once

#include <pybind11/pybind11.h>

#include <string>

/// What the module tactus._core is made of; src/python/tactus is what people import. Shapes, units
/// and errors are said there.
namespace tactus {

/// InputError becomes tactus.ConfigError, RunError tactus.RunError.
void bindErrors();
void bindColumns(pybind11::module_& module);
void bindScene(pybind11::module_& module);
void bindRuns(pybind11::module_& module);
void bindController(pybind11::module_& module);

/// While it is there other threads of Python go on. A daemon thread that wants the interpreter's
/// lock back while Python ends sleeps for ever, as of Python 3.14 on: those before end it by
/// unwinding its stack, which this destructor would turn into an abort of the process.
class LockRelease {
 public:
  LockRelease() : state_(PyEval_SaveThread()) {}
  ~LockRelease();
  LockRelease(const LockRelease&) = delete;
  LockRelease& operator=(const LockRelease&) = delete;

 private:
  PyThreadState* state_;
};

/// Of functions that take long and touch nothing of Python: other threads of it go on.
using WithoutLock = pybind11::call_guard<LockRelease>;

/// A class whose objects come from functions of the module alone: pybind11 would hand out the
/// memory of one that __new__ has made, and that no __init__ has filled.
template <typename Value>
pybind11::class_<Value> classOf(pybind11::module_& module, const char* name, const char* doc) {
  const auto refuse_new = [](PyHeapTypeObject* type) {
    type->ht_type.tp_new = nullptr;
    type->ht_type.tp_flags |= Py_TPFLAGS_DISALLOW_INSTANTIATION;
  };
  return {module, name, doc, pybind11::is_final(), pybind11::custom_type_setup(refuse_new)};
}

/// To be called now and then by what runs without the interpreter's lock, so that Ctrl-C ends it.
void lookForSignals();

/// A text of a user, which may be no UTF-8.
pybind11::str textOf(const std::string& text);

}  // namespace tactus
