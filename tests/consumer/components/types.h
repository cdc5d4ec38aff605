// A header of the user's own, by a name that Skerry uses inside.
#pragma once

using Mine = int;
