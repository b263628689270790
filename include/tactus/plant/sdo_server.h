#pragma once

#include "tactus/canopen/can_frame.h"
#include "tactus/plant/object_dictionary.h"

namespace tactus {

/// Answers an SDO client (CiA 301): expedited transfers of up to four bytes; whatever else is asked
/// for is aborted. False if there is nothing to answer: a frame of wrong size, or an abort.
bool answerSdo(const CanFrame& request, ObjectDictionary& objects, CanFrame& response) noexcept;

}  // namespace tactus
