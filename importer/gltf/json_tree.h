// Functions that build, change and take apart JSON values in place, so that running out of memory is an
// exception and never ends the program. They are needed because nlohmann's destructor (3.11) allocates for
// every value that has children, and an allocation that fails there cannot be reported; and because its
// ordered objects copy their members, and destroy the old ones, when they grow or lose one.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace loden::importer {

// Empties an array or object from its leaves up, after which its destructor has nothing to allocate for. The
// recursion is as deep as the value.
void takeApart(nlohmann::ordered_json& value) noexcept;

// Parses the text into `root`, which must be null. If memory runs out, `root` holds what was parsed so far,
// and must be taken apart. Returns false if the text is not JSON.
bool parseInto(nlohmann::ordered_json& root, std::string_view text);

// Takes `value` apart and puts null in its place.
void setNull(nlohmann::ordered_json& value) noexcept;
// The object's member, which is added as null if there is none. If `object` is null it becomes an object
// first.
nlohmann::ordered_json& memberOf(nlohmann::ordered_json& object, const std::string& key);
// The object's member as an array, which is added as an empty one if it is absent. A member of another type
// is replaced by an empty array; callers refuse those first (wrongTypes in gltf_document.h).
nlohmann::ordered_json& listOf(nlohmann::ordered_json& object, const std::string& key);
// A new, null element at the end of an array.
nlohmann::ordered_json& appendTo(nlohmann::ordered_json& array);
// Sets the value to an array of these numbers.
void setNumbers(nlohmann::ordered_json& value, std::initializer_list<double> numbers);
// Removes those members of the object for whose names `goes` returns true.
template <class Goes>
void removeMembers(nlohmann::ordered_json& object, const Goes& goes) {
  using Members = nlohmann::ordered_json::object_t;
  auto& members = object.get_ref<Members&>();
  Members kept;  // their values are moved here once no allocation follows
  kept.reserve(members.size());
  for (const auto& [name, value] : members)
    if (!goes(name)) kept.emplace_back(name, nullptr);
  auto next = kept.begin();
  for (auto& [name, value] : members)
    if (next != kept.end() && next->first == name)
      (next++)->second.swap(value);
    else
      setNull(value);
  members.swap(kept);
}

}  // namespace loden::importer
