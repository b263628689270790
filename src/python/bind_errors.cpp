#include <cxxabi.h>

#include <chrono>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "tactus/python/bindings.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/input_error.h"

namespace py = pybind11;

namespace tactus {
namespace {

template <typename... Arguments>
void raise(const char* type, Arguments... arguments) {
  const py::object error = py::module_::import("tactus.errors").attr(type)(arguments...);
  PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
}

/// Runs what takes the interpreter's lock, unless Python ends.
template <typename Take>
void takeLock(Take take) {
  try {
    take();
  } catch (const abi::__forced_unwind&) {  // pthread_exit(), which nothing here is made for
    while (true) std::this_thread::sleep_for(std::chrono::hours(1));
  }
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const LocatedError& error) {
    const ErrorPlace& at = error.place;
    raise("ConfigError", textOf(error.what()), textOf(at.file), at.line, at.column, textOf(at.key));
  } catch (const InputError& error) {
    raise("ConfigError", textOf(error.what()));
  } catch (const RunError& error) {
    raise("RunError", textOf(error.what()));
  }
}

}  // namespace

void bindErrors() { py::register_exception_translator(&translate); }

py::str textOf(const std::string& text) {
  PyObject* const decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape");
  if (!decoded) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

LockRelease::~LockRelease() {
  takeLock([this] { PyEval_RestoreThread(state_); });
}

void lookForSignals() {
  std::optional<py::gil_scoped_acquire> acquire;
  takeLock([&] { acquire.emplace(); });
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace tactus
