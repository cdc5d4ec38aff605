// A header of the user's own. Its name is the name of a header inside Skerry.
#pragma once

using Mine = int;
