#include "textbook_methods.h"

namespace tactus {

template std::vector<PseudoinverseMethod<double>> textbookMethods<double>();

}  // namespace tactus
