#include "test/pictures.h"
const TestCase test_progressive[] = { { NULL, NULL, false } };
