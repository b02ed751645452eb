#pragma once
#include "dynamics/rigid/rigid.h"
#include "host/io/csv.h"
