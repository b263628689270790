#include "textbook_methods.h"

namespace tactus {

template std::vector<PseudoinverseMethod<float>> textbookMethods<float>();

}  // namespace tactus
