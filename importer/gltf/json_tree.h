// JSON values that are built, changed and taken apart in place, so that too little memory is an exception and
// never the end of the program. nlohmann's destructor (3.11) allocates for every value that has children, and
// an allocation that fails there cannot be reported; its ordered objects copy their members, and destroy the
// old ones, where they grow or lose one.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace loden::importer {

// Empties an array or object from its leaves up, after which its destructor has nothing to allocate for. It
// calls itself as often as the value is deep.
void takeApart(nlohmann::ordered_json& value) noexcept;

// Parses into `root`, which must be null, and leaves there what it has got to if memory runs out: to be taken
// apart. False if the text is no JSON.
bool parseInto(nlohmann::ordered_json& root, std::string_view text);

// Takes `value` apart and puts null in its place.
void setNull(nlohmann::ordered_json& value) noexcept;
// The object's member, added as null if there is none; what is null becomes an object first.
nlohmann::ordered_json& memberOf(nlohmann::ordered_json& object, const std::string& key);
// The member as an array: another value, or none, is replaced by an empty one.
nlohmann::ordered_json& listOf(nlohmann::ordered_json& object, const std::string& key);
// A new, null element at the end of an array.
nlohmann::ordered_json& appendTo(nlohmann::ordered_json& array);
// Makes the value an array of these.
void setNumbers(nlohmann::ordered_json& value, std::initializer_list<double> numbers);
// The object without those of its members whose name `goes` is true of.
template <class Goes>
void removeMembers(nlohmann::ordered_json& object, const Goes& goes) {
  using Members = nlohmann::ordered_json::object_t;
  auto& members = object.get_ref<Members&>();
  Members kept;  // with their values once no allocation follows
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
