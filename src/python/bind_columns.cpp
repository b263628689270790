#include <pybind11/numpy.h>

#include "tactus/python/bindings.h"
#include "tactus/python/columns.h"

namespace py = pybind11;

namespace tactus {
namespace {

py::dtype typeOf(FieldType type) {
  if (type == FieldType::kDouble) return py::dtype::of<double>();
  return type == FieldType::kInt64 ? py::dtype::of<std::int64_t>() : py::dtype::of<std::uint64_t>();
}

/// Shows the field's memory, which lives as long as the array does, and is read only.
py::array arrayOf(const py::object& owner, const std::string& name) {
  const auto& columns = owner.cast<const Columns&>();
  const Columns::Field* const field = columns.find(name);
  if (!field) throw py::key_error(name);
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(columns.cycles())};
  if (field->is_array) shape.push_back(static_cast<py::ssize_t>(field->entries));
  py::array array(typeOf(field->field->type), shape, field->words.data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::dict units(const Columns& columns) {
  py::dict units;
  for (const Columns::Field& field : columns.fields()) units[field.field->name] = field.field->unit;
  return units;
}

/// (name, field, entry) of each column of the CSV.
py::list places(const Columns& columns) {
  py::list places;
  for (const Columns::Place& place : columns.places())
    places.append(py::make_tuple(place.name, place.field, place.entry));
  return places;
}

}  // namespace

void bindColumns(py::module_& module) {
  classOf<Columns>(module, "Columns", "All cycles of a run; made by simulate() and read_log().")
      .def_property_readonly("cycles", &Columns::cycles)
      .def("units", &units)
      .def("places", &places)
      .def("array",
           [](const py::object& self, const std::string& name) { return arrayOf(self, name); });
}

}  // namespace tactus
