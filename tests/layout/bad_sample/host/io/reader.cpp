#include "dynamics/dynamics.h"
#include "dynamics/rigid/rigid.h"
