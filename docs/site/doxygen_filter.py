#!/usr/bin/env python3
"""Prints a header with its `//` comments as docstrings, as doxygen expects them.

- The comment at the top describes the file.
- A comment behind a member describes this member.
- A comment above a member, without an empty line before it, describes this member too.
- A comment after an empty line or `public:` in a class is the title of the members that follow.
- The members of one declaration become one declaration each, with the same comment.
- A function without a comment, below a function of the same name, gets the comment of that function.
- Destructors, move constructors and defaulted functions without a comment are left out.
"""

import re
import sys

COMMENT = re.compile(r"( *)//(?!/) ?(.*)")
BEHIND = re.compile(r"(.*[^\s/].*?)\s+//(?!/) (.*)")
MEMBER = r"\w+(?:\{\}| = [^,;(){}]+(?:\(\))?)?"
MEMBERS = re.compile(rf"( +)([\w:]+(?:<[^;]*>)?) ({MEMBER}(?:, {MEMBER})+);( +///< .*)?")
SPECIAL = re.compile(r".*(= default;|~\w+\(\);|\(\w+&&\) noexcept;)")
FUNCTION = re.compile(r" *(?:[\w:]+(?:<[^;()]*>)?[&*]? )+[&*]?(\w+)\(")


def docstrings_of(lines: list[str]) -> list[str]:
    """The lines of a header after the conversion."""
    result: list[str] = []
    in_group = False
    at = 0
    while at < len(lines):
        comment = COMMENT.fullmatch(lines[at])
        if comment is None:
            if in_group and re.match(r"\};|private:|protected:", lines[at].strip()):
                result.append("///@}")
                in_group = False
            result.append(BEHIND.sub(r"\1  ///< \2", lines[at]))
            at += 1
            continue
        end = at
        while end < len(lines) and (more := COMMENT.fullmatch(lines[end])) and more[1] == comment[1]:
            end += 1
        text = [COMMENT.fullmatch(line)[2] for line in lines[at:end]]
        before = lines[at - 1].strip() if at else ""
        if at == 0:
            result += ["/// @file", *("/// " + line for line in text)]
        elif before and before != "public:":
            behind = re.search(r"///<", result[-1])
            result += [("///< " if behind and len(comment[1]) > 20 else "/// ") + line for line in text]
        elif comment[1]:
            title, _, rest = " ".join(text).partition(". ")
            result += ["///@}"] if in_group else []
            result += [f"/// @name {title.rstrip('.')}", f"/// {rest}", "///@{"]
            in_group = True
        at = end
    return result


def with_shared_docstrings(lines: list[str]) -> list[str]:
    """Repeats docstrings that describe several members."""
    result: list[str] = []
    above: list[str] = []  # docstring above the present line
    last, described = "", []  # name and docstring of the function before this line
    starts = True  # true if a declaration may start in this line
    for line in lines:
        if re.match(r" */// (?!@)", line):
            above.append(line)
            result.append(line)
            continue
        if not above and SPECIAL.fullmatch(line):
            continue
        members, function = MEMBERS.fullmatch(line), FUNCTION.match(line) if starts else None
        if members and (above or members[4]):
            for number, member in enumerate(members[3].split(", ")):
                result += above if number else []
                result.append(f"{members[1]}{members[2]} {member};{members[4] or ''}")
        else:
            if function:
                behind = re.search(r"///<( .*)", line)
                own = above or ([f"    ///{behind[1]}"] if behind else [])
                result += described if not own and function[1] == last else []
                last, described = function[1], own or (described if function[1] == last else [])
            elif starts:
                last, described = "", []
            result.append(line)
        above = []
        starts = bool(re.search(r"([;{}:>]|^|///.*)$", line))
    return result


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as header:
        print("\n".join(with_shared_docstrings(docstrings_of(header.read().splitlines()))))
